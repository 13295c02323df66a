"""``python -m scuro`` is ``scuro``."""

from scuro.app.cli import main

main()
