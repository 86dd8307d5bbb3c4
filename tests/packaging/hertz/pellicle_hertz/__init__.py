"""The force on a rigid sphere."""
