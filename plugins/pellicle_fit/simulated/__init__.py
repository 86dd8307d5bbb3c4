"""Force curves of indenters and solids that have none of their own, from studies."""
