"""Plug-ins for hystbench from another package: good ones and bad ones."""
