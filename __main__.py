"""``python -m hystbench`` is the ``hystbench`` command."""

from .bench.cli import main

if __name__ == "__main__":
    main()
