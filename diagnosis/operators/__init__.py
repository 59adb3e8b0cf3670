"""Compiled laws of which effects and emulators are made: with memory, with a mass, of broken order."""
