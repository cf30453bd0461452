"""``python -m simcompare``."""

from simcompare.cli import main

if __name__ == "__main__":
    main()
