"""Old name of `validation_cases`, for installations made before it was renamed."""

from .validation_cases import register_validations as register_validations
