"""A probe sphere that a hand moves and that cannot enter the atoms (HaptiMOL iSAS)."""
