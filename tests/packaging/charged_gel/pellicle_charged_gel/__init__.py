"""Effects of charged gels."""
