"""What force a material gives at a depth."""
