"""The configuration of runs and studies: models, JSON schema, description and provenance."""
