# Makes Doxygen's comments of plain ones: the first describes the file, one behind code what stands before it.
# SPDX-License-Identifier: Apache-2.0
s|^// SPDX-License.*|//|
\|^ *// ---|s|.*||
\|^ *//| {
  s/[\\@<#]/\\&/g
  s|//|///|
}
\|^ *//|! {
  \|[;,{}] *// | {
    h
    s|^.*[;,{}] *// \(.*\)$|\1|
    s/[\\@<#]/\\&/g
    x
    s|^\(.*[;,{}]\) *// .*$|\1|
    G
    s|\n| ///< |
  }
}
1s|^/// |/// @file\n/// |
