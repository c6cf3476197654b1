"""The results page: tables, goals and pictures from the numbers that the benchmark programs wrote."""
