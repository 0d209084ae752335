// How work is cut into dispatches.
const RUN: u32 = 64u;            // elements that one invocation of a scan walks; invocations of a group per visible agent
const MOST_GROUPS: u32 = 65535u; // workgroups along one axis that every device takes
