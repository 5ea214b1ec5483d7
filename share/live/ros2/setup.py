"""Packs the example. underbrush_live.py and sensor_server.proto, which stand above this folder, travel with it."""
import pathlib
import shutil

from setuptools import setup

HERE = pathlib.Path(__file__).resolve().parent
NAME = "underbrush_live_ros"
for file in ("underbrush_live.py", "sensor_server.proto"):
    if (HERE.parent / file).exists():
        shutil.copyfile(HERE.parent / file, HERE / NAME / file)

setup(name=NAME, version="0.1.0", packages=[NAME], package_data={NAME: ["sensor_server.proto"]}, license="Apache-2.0",
      data_files=[("share/ament_index/resource_index/packages", [f"resource/{NAME}"]), (f"share/{NAME}", ["package.xml"])],
      install_requires=["setuptools", "grpcio", "grpcio-tools", "numpy"],
      entry_points={"console_scripts": [f"node = {NAME}.node:main"]})
