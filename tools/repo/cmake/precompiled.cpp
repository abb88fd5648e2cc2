// Nothing: a target needs a source to own a precompiled header.
// SPDX-License-Identifier: Apache-2.0
