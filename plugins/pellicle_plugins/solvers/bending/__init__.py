"""What a skin with bending stiffness needs, where cells cannot change sides one by one."""
