"""What our own outputs keep beyond the contract."""

from pathlib import Path

import pytest

from pellicle import Output, Place, StorageError


def test_a_folder_that_cannot_be_written_comes_with_a_remedy(
    output: Output, tmp_path: Path
) -> None:
    """Opening fails with the name of the file and what to do."""
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(StorageError, match=r"indent.*cannot be written.*choose another folder"):
        output.open(Place(tmp_path / "file" / "folder", "indent", "{}"))
