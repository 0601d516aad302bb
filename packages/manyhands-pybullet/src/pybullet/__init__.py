"""manyhands' module under the name that programs import."""

from manyhands.compat.stand_in import take_place

take_place(__name__)
