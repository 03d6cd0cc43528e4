"""The papers, each as one module or package of claims: its equations beside what follows from the model."""
