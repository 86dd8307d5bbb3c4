"""Pages, for plugins: the contents of `pellicle.report.page`."""

from pellicle.model.html import summary as summary
from pellicle.report.page import Block as Block
from pellicle.report.page import Cell as Cell
from pellicle.report.page import Code as Code
from pellicle.report.page import Column as Column
from pellicle.report.page import Field as Field
from pellicle.report.page import Frame as Frame
from pellicle.report.page import Maps as Maps
from pellicle.report.page import Notice as Notice
from pellicle.report.page import Picture as Picture
from pellicle.report.page import Section as Section
from pellicle.report.page import Table as Table
from pellicle.report.page import Text as Text
from pellicle.report.page import frame as frame
from pellicle.report.page import page as page
from pellicle.report.page import side as side
