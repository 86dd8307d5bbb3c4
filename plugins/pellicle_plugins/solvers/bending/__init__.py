"""Contact under a skin with bending stiffness, where cells cannot change sides one by one."""
