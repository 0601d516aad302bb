"""`python -m manyhands` is the command `manyhands`."""

import sys

from manyhands_command import main

sys.exit(main())
