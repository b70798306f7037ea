//! Whose contact is it: the land's, the edit tool's or a control's; and the controls of each side of the table.
