"""The paper's robot as a computer: its numbers, the schedule (Eqs. 1-3), the radio (Eqs. 4-7)."""
