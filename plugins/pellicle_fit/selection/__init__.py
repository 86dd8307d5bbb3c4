"""Which explanations of curves hold: rivals, the verdict, and what to do next."""
