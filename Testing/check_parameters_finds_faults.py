# SPDX-License-Identifier: BSD-3-Clause
"""check-parameters.py finds where pages and the plugin's XML disagree, and nothing else."""
from checkers import complaints

XML = """<ServerManagerConfiguration><ProxyGroup name="filters">
<SourceProxy name="LacunaGoodFilter" class="vtkLacunaGoodFilter" label="Good Filter">
  <Documentation short_help="x" long_help="x">x</Documentation>
  <InputProperty name="Input"/>
  <InputProperty name="Mask"><Hints><Optional/></Hints></InputProperty>
  <DoubleVectorProperty name="Width" default_values="0.5"/>
  <DoubleVectorProperty name="Low" default_values="-45"/>
  <DoubleVectorProperty name="High" default_values="2000000"/>
  <IntVectorProperty name="Shape" default_values="1"><EnumerationDomain>
    <Entry text="Square" value="0"/><Entry text="Round" value="1"/></EnumerationDomain></IntVectorProperty>
  <IntVectorProperty name="Cap" default_values="1"><BooleanDomain/></IntVectorProperty>
  <StringVectorProperty name="Array" default_values=""/>
</SourceProxy></ProxyGroup></ServerManagerConfiguration>
"""
PAGE = """# Good Filter
| name | default | unit | meaning |
|---|---|---|---|
| `Width` | 0.50 | mm | |
| `Low`, `High` | −45, 2 000 000 | | |
| Shape | `Round` | | Square or Round |
| `Cap` (advanced) | on | | `Mask` says where |
| `Array` | empty | | |
"""


def check(page=PAGE, xml=XML, readme="| [x](good-filter.md) | y |", name="good-filter.md"):
    return complaints("check-parameters.py", {"Plugins/Lacuna/Filters/GoodFilter.xml": xml, "Documentation/UserGuide/README.md": readme,
                                              "Documentation/UserGuide/" + name: page})


assert check() == "", check()
for old, new, complaint in (
        ("0.50", "0.6", "line 4: the default of Width is '0.5', not '0.6'"),
        ("−45, 2", "45, 2", "the default of Low"), ("2 000 000", "200 000", "the default of High"),
        ("`Round`", "`Square`", "the default of Shape is 'Round'"), ("Square or", "Oval or", "does not name Square"),
        ("| on |", "| off |", "the default of Cap"), ("| empty |", "| Depth |", "the default of Array"),
        ("| `Array` | empty | | |\n", "", "does not name the property Array"), ("`Mask`", "mask", "does not name the property Mask"),
        ("`Width`", "`Breadth`", "Good Filter has no property Breadth")):
    assert complaint in check(PAGE.replace(old, new)), (complaint, check(PAGE.replace(old, new)))
assert "the default of Width is '2', not '0.50'" in check(xml=XML.replace('"0.5"', '"2"'))
assert "missing, the page of Good Filter" in check(name="other.md")
assert "begin with a link to good-filter.md, not one" in check(readme="| [x](good-filter.md) | y |\n" * 2)
assert "begin with a link to good-filter.md, not one" in check(readme="See [x](good-filter.md)")
print("ok")
