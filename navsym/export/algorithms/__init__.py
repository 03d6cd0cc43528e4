"""Ready-made algorithms, each composed of claims of the papers and of links with theorems of their own."""
