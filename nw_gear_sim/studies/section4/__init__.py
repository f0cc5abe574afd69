"""The paper's Sec. 4 statement by statement, and the search for the parameters it doesn't give."""
