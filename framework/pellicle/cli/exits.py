"""Exit codes."""

NOT_CONVERGED, BAD_INPUT, CRASHED, INTERRUPTED = 1, 2, 70, 130
"""70 is EX_SOFTWARE of sysexits.h; Python's own 1 for a traceback would mean NOT_CONVERGED."""
