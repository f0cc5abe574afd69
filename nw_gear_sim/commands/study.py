"""`nw_gear study ...`: the paper's studies."""

from __future__ import annotations

import typer

from nw_gear_sim.commands.bifurcation import bifurcation
from nw_gear_sim.commands.claims import claims
from nw_gear_sim.commands.lyapunov import lyapunov
from nw_gear_sim.commands.response import response
from nw_gear_sim.commands.superharmonic import superharmonic

study = typer.Typer(no_args_is_help=True, rich_markup_mode=None, help="The paper's studies, for this gearbox or yours.")
study.command("bifurcation")(bifurcation)
study.command("claims")(claims)
study.command("lyapunov")(lyapunov)
study.command("response")(response)
study.command("superharmonic")(superharmonic)
