"""The paper's robot as a computer: its numbers, the schedule (Eqs. 1-3), the radio (Eqs. 4-7).

Comes in: figures of the paper, and what follows from them about time and messages.
"""
