"""Figures, for plugins: the public part of `pellicle.report`."""

from pellicle.report.fields import extent as extent
from pellicle.report.fields import pressure_map as pressure_map
from pellicle.report.fields import profile as profile
from pellicle.report.fields import without_round_off as without_round_off
from pellicle.report.lines import edge_cells as edge_cells
from pellicle.report.plotting import FIGURES as FIGURES
from pellicle.report.plotting import STUDY_FIGURES as STUDY_FIGURES
from pellicle.report.plotting import area_force as area_force
from pellicle.report.plotting import drawings as drawings
from pellicle.report.plotting import force_depth as force_depth
from pellicle.report.plotting import over_time as over_time
from pellicle.report.plotting import save_figures as save_figures
from pellicle.report.plotting import save_study_figures as save_study_figures
from pellicle.report.plotting import study_curves as study_curves
from pellicle.report.saving import save_figure as save_figure
from pellicle.report.saving import save_pages as save_pages
from pellicle.report.saving import svg as svg
from pellicle.report.style import LINES as LINES
from pellicle.report.style import FigureStyle as FigureStyle
from pellicle.units import axis_unit as axis_unit
