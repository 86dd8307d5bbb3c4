"""What the tests of bad input share: how a message reads."""


def says(message: str, *words: str) -> None:
    """Check that a message holds all words and none of pydantic's."""
    for word in words:
        assert word in message, f"{word!r} is not in: {message}"
    assert "Input should" not in message
    assert "validation" not in message
