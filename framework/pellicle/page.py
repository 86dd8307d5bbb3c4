"""Pages, for plugins: the contents of `pellicle.report.page`."""

from pellicle.report.page import Column as Column
from pellicle.report.page import Notice as Notice
from pellicle.report.page import Picture as Picture
from pellicle.report.page import Section as Section
from pellicle.report.page import Table as Table
from pellicle.report.page import page as page
