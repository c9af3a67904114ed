#!/usr/bin/env python3
"""Writes reference values of torch_geometric's FeaStConv for the tests of garnet-kernel.

    pip install torch torch_geometric
    python benches/python/feast_reference.py > crates/garnet-kernel/tests/data/feast_conv.json

Outputs and gradients of sum(y * dy) are computed in double precision from inputs that are exact in
single precision. Nothing else needs this script: the file it writes is part of the repository.
"""

import json
import sys

import torch
import torch_geometric
from torch_geometric.nn import FeaStConv


def single(values):
    """Values that single precision represents exactly, as double precision."""
    return values.float().double()


def case(num_vertices, in_channels, out_channels, heads, edges, generator):
    conv = FeaStConv(in_channels, out_channels, heads=heads, add_self_loops=True).double()
    draw = lambda *shape: single(torch.randn(*shape, generator=generator, dtype=torch.float64))
    with torch.no_grad():
        for parameter in conv.parameters():
            parameter.copy_(draw(*parameter.shape) * 0.5)
    x = draw(num_vertices, in_channels).requires_grad_()
    dy = draw(num_vertices, out_channels)
    # Messages go from row 0 to row 1 of edge_index: vertex i takes from its neighbor j.
    edge_index = torch.tensor([[j for i, j in edges], [i for i, j in edges]])
    y = conv(x, edge_index)
    (y * dy).sum().backward()

    # lin.weight is [heads * out, in]; the kernel takes [heads * in, out].
    def rows_of_heads(weight):
        return weight.view(heads, out_channels, in_channels).transpose(1, 2).reshape(-1)

    listed = lambda values: [float(v) for v in values.detach().reshape(-1)]
    lists = [[j for i, j in edges if i == vertex] for vertex in range(num_vertices)]
    return {
        "num_vertices": num_vertices,
        "in_channels": in_channels,
        "out_channels": out_channels,
        "num_heads": heads,
        "neighbors": lists,
        "x": listed(x),
        "u": listed(conv.u.weight.t()),
        "c": listed(conv.c),
        "w": listed(rows_of_heads(conv.lin.weight)),
        "b": listed(conv.bias),
        "dy": listed(dy),
        "y": listed(y),
        "dx": listed(x.grad),
        "du": listed(conv.u.weight.grad.t()),
        "dc": listed(conv.c.grad),
        "dw": listed(rows_of_heads(conv.lin.weight.grad)),
        "db": listed(conv.bias.grad),
    }


def main():
    generator = torch.Generator().manual_seed(1)
    fan = [(0, 1), (0, 2), (0, 3), (1, 0), (1, 2), (2, 0), (2, 1), (2, 3), (3, 0), (3, 2)]
    ring = [(i, (i + step) % 7) for i in range(7) for step in (1, 6, 3)]
    result = {
        "made_by": "benches/python/feast_reference.py",
        "torch": torch.__version__.split("+")[0],
        "torch_geometric": torch_geometric.__version__,
        "cases": [
            # Vertex 4 has no neighbors.
            case(5, 3, 2, 8, fan, generator),
            case(7, 5, 4, 1, ring, generator),
            case(7, 4, 3, 9, ring, generator),
        ],
    }
    json.dump(result, sys.stdout, indent=1)
    print()


if __name__ == "__main__":
    main()
