"""The blind check: recordings whose cause is sealed, diagnosed, then scored."""
