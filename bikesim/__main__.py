"""python -m bikesim"""

import sys

from bikesim.cli.entry import main

sys.exit(main())
