"""From stress histories to damage: rainflow cycles, life, Miner's sum, statistics over asperities."""
