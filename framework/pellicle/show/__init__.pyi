__all__: list[str]

from .drawing import draw as draw
from .fields import without_round_off as without_round_off
from .html import Block as Block
from .html import Code as Code
from .html import Notice as Notice
from .html import Picture as Picture
from .html import Section as Section
from .html import Text as Text
from .html import page as page
from .maps import Field as Field
from .maps import Frame as Frame
from .maps import Maps as Maps
from .maps import frame as frame
from .maps import side as side
from .notebook import summary as summary
from .rim import up_to_rim as up_to_rim
from .rim import with_rim as with_rim
from .saving import figure_of as figure_of
from .saving import figures as figures
from .saving import png as png
from .saving import save_figure as save_figure
from .saving import save_pages as save_pages
from .saving import svg as svg
from .saving import write_charts as write_charts
from .style import LINES as LINES
from .style import FigureStyle as FigureStyle
