"""Circles of a graph of imports: its strongly connected parts of more than one node."""

Graph = dict[str, set[str]]


def circles_of(graph: Graph) -> list[list[str]]:
    """Each sorted; one that reaches itself counts too. Tarjan's algorithm, with its own stack."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    path: list[str] = []
    found = []

    def enter(node: str) -> tuple[str, list[str]]:
        index[node] = low[node] = len(index)
        path.append(node)
        return node, sorted(graph.get(node, ()), reverse=True)

    for start in sorted(graph):
        work = [enter(start)] if start not in index else []
        while work:
            node, left = work[-1]
            if left:
                target = left.pop()
                if target not in index:
                    work.append(enter(target))
                elif target in path:
                    low[node] = min(low[node], index[target])
                continue
            work.pop()
            if work:
                low[work[-1][0]] = min(low[work[-1][0]], low[node])
            if low[node] == index[node]:
                part = path[path.index(node) :]
                del path[path.index(node) :]
                if len(part) > 1 or node in graph.get(node, ()):
                    found.append(sorted(part))
    return sorted(found)


def merged(graph: Graph, name_of) -> Graph:
    """The same between groups; what stays inside a group is no edge."""
    groups: Graph = {}
    for node, targets in graph.items():
        group = groups.setdefault(name_of(node), set())
        group |= {name_of(target) for target in targets} - {name_of(node)}
    return groups
