"""Install nw_gear as an ament_python package (colcon) or as a plain Python package (pip)."""

import re
from pathlib import Path

from setuptools import find_packages, setup

NAME = "nw_gear"
EXECUTABLES = (
    "wind_node",
    "gear_sim_node",
    "gear_monitor_node",
    "recorder_node",
    "replay_node",
    "dashboard_node",
    "nw_gear",
)
VERSION = re.findall(r'__version__ = "(.+)"', Path("nw_gear_common/__init__.py").read_text(encoding="utf-8"))[0]

# ROS itself isn't listed: it comes from the distribution or from requirements/runtime.txt.
RUNTIME = (
    "numpy",
    "scipy",
    "numba>=0.68,<0.69",  # compiled.py uses an undocumented option of it
    "PyYAML>=6",
    "mcap>=1.2",
    "mcap-ros2-support>=0.5",
    "zstandard",
    "bokeh>=3.9,<3.10",  # the live page overrides parts of its server
    "tornado>=6.4",
    "Jinja2",
    "MarkupSafe",
    "typer>=0.12",
    "rich",
    "PyWavelets>=1.6",
    "pyarrow>=17",
)


def files(folder: str, *patterns: str) -> list[str]:
    """Files of one folder for data_files."""
    return sorted(str(path) for pattern in patterns for path in Path(folder).glob(pattern))


setup(
    name=NAME,
    version=VERSION,
    packages=find_packages(include=["nw_gear_*"]),
    package_data={"": ["py.typed", "*.html", "*.css", "*.js", "*.csv"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/config", files("config", "*.yaml", "*.json", "*.xml")),
        (f"share/{NAME}/launch", files("launch", "*.launch.py")),
        (f"lib/{NAME}", [f"scripts/{name}" for name in EXECUTABLES]),  # where `ros2 run` looks, also after pip
    ],
    python_requires=">=3.11",
    install_requires=["setuptools", *RUNTIME],
    extras_require={
        "cluster": ["distributed"],  # studies on a Dask cluster
        "test": ["pytest", "hypothesis", "rosbags"],  # without a pytest here `colcon test` runs no test
    },
    zip_safe=False,
    maintainer="nw_gear maintainers",
    maintainer_email="maintainers@users.noreply.nw-gear.example",
    description="Virtual condition monitoring of a wind turbine's planetary gearbox.",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [f"{name} = nw_gear_common.launcher:{name}" for name in EXECUTABLES],
        "nw_gear.benchmarks": [
            "monitor = nw_gear_monitor.bench:measure",
            "peers = nw_gear_monitor.bench_peers:measure",
            "simulator = nw_gear_sim.bench.measure:measure",
        ],
        "nw_gear.commands": [
            "analyse = nw_gear_monitor.analyse.command:analyse",
            "bench = nw_gear_common.bench:bench",
            "demo = nw_gear_common.demo:demo",
            "review = nw_gear_monitor.review.command:review",
            "info = nw_gear_monitor.records.command_info:info",
            "modes = nw_gear_sim.commands.modes:modes",
            "equilibrium = nw_gear_sim.commands.equilibrium:equilibrium",
            "study = nw_gear_sim.commands.study:study",
            "import = nw_gear_monitor.foreign.command:import_file",
            "recover = nw_gear_monitor.records.command_recover:recover",
        ],
    },
)
