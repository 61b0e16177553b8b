"""Fatigue damage of stress histories: rainflow cycles, life, Miner's sum, statistics over asperities."""
