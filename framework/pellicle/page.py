"""Pages, for plugins: the contents of `pellicle.report.page` and `pellicle.report.maps`."""

from pellicle.model.html import summary as summary
from pellicle.report.maps import Field as Field
from pellicle.report.maps import Frame as Frame
from pellicle.report.maps import Maps as Maps
from pellicle.report.maps import frame as frame
from pellicle.report.maps import side as side
from pellicle.report.page import Block as Block
from pellicle.report.page import Cell as Cell
from pellicle.report.page import Code as Code
from pellicle.report.page import Column as Column
from pellicle.report.page import Notice as Notice
from pellicle.report.page import Picture as Picture
from pellicle.report.page import Section as Section
from pellicle.report.page import Table as Table
from pellicle.report.page import Text as Text
from pellicle.report.page import page as page
