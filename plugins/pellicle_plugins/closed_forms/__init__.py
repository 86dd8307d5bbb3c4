"""Contacts with a solution in closed form, named by their authors."""
