"""Control laws: bounds, tables, the plant behind them, and how it is identified."""
