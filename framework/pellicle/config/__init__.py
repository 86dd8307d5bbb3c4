"""The configuration of runs and studies: their models, schema, description and origin."""
