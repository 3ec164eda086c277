"""Tools for the results of democles: pictures, plots, studies.
Each tool is a module with a function main(), see scripts/tool.py."""
