"""Found under its name by processes that a program under `manyhands.compat` starts."""

from manyhands.compat.stand_in import take_place

take_place(__name__)
