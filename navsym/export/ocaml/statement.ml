(* Statements and their goals. Sections 5 and 9 of docs/certificates.md. *)

open Text
open Tree
open Ball
open Value
open Goal
open Language

(* A statement, or one of the cases into which it falls *)
type statement = {
  goals : (tree * relation) list;
  box : (string * range) list;
  said : tree list; (* what has to have a value *)
  given : tree list;
  zeros : tree list;
  fractions : (string * tree) list; (* symbols for u minus the whole part of u *)
}

let read_goals left right relation tolerance =
  let scalars () =
    match (left, right) with Scalar a, Scalar b -> (a, b) | _ -> refuse "matrices are equal or not, and have no other relation"
  in
  let differences () = entries (combine (function [ a; b ] -> subtract a b | _ -> assert false) [ left; right ]) in
  let difference () = let a, b = scalars () in subtract a b in
  let opposite () = let a, b = scalars () in subtract b a in
  match (relation, tolerance) with
  | "=", None -> List.map (fun d -> (d, Equal)) (differences ())
  | "=", Some e ->
      let d = difference () in
      [ (Sum [ e; d ], AtLeast); (Sum [ e; negate d ], AtLeast) ]
  | _, Some _ -> refuse "a tolerance goes with = only"
  | "!=", None -> (
      match (left, right) with
      | Scalar a, Scalar b -> [ (subtract a b, Unequal) ]
      | _ -> [ (Sum (zero :: List.map (fun d -> Prod [ d; d ]) (differences ())), Unequal) ])
  | ">", None -> [ (difference (), Above) ]
  | ">=", None -> [ (difference (), AtLeast) ]
  | "<", None -> [ (opposite (), Above) ]
  | "<=", None -> [ (opposite (), AtLeast) ]
  | _ -> refuse "unknown relation %S" relation

let plain_keys = [ "left"; "right"; "relation"; "symbols"; "exists"; "tolerance" ]
let more_keys = [ "shapes"; "given"; "rates" ]

(* O(s^n): the derivatives of order 0 to n - 1 at s = 0. What is typed has to be differentiable there. *)
let read_order box (context : context) value =
  match get_object "order" value with
  | [ (s, n) ] ->
      let n = get_integer "order" 1 8 n in
      let range : range = match List.assoc_opt s box with Some r -> r | None -> refuse "order: unknown symbol %s" s in
      let ball t = number_ball "order" t in
      let reaches t = Algebra.vanishes t || is_above (ball t) in
      let is_limit =
        (match range.low with None -> true | Some t -> reaches (negate t)) && match range.high with None -> true | Some t -> reaches t
      in
      let has_inside = match (range.low, range.high) with Some a, Some b -> is_above (ball (subtract b a)) | _ -> true in
      shown "order: 0 is no limit of the symbol" ((not range.integer) && is_limit && has_inside);
      let has_symbol t = Names.mem s (symbols t) in
      if List.exists has_symbol (context.given @ context.zeros) then refuse "order: a hypothesis with the symbol";
      (s, n)
  | _ -> refuse "order: expected one symbol"

let expand_order (context : context) (s, n) goals =
  if context.fractions <> [] then refuse "an order of a floor";
  let at_zero = put [ (s, zero) ] in
  let derivatives (d, _) =
    let rec go k d = if k = n then [] else (at_zero d, Equal) :: go (k + 1) (Calculus.derive s d) in
    go 0 d
  in
  (List.concat_map derivatives goals, at_zero)

let read_case values long_values order random plan ~answers ~point =
  match values @ long_values with
  | [ left; right; relation; symbols; exists; tolerance; shapes; given; rates ] ->
      let read (name, v) = if is_name name then (name, read_range name v) else refuse "expected a name" in
      let box = List.map read (get_object "symbols" symbols) in
      if List.exists (fun (name, _) -> List.mem_assoc name box) random then refuse "random: a name with a range";
      let context = make_context box plan shapes rates random in
      List.iter (fun v -> suppose context (read_condition context (get_text "given" v))) (get_list "given" given);
      List.iter (fun v -> ignore (read_value_of context (get_text "exists" v))) (get_list "exists" exists);
      let left = read_value_of context (get_text "left" left) in
      let right = read_value_of context (get_text "right" right) in
      let tolerance = match tolerance with Null -> None | v -> Some (get_tree "tolerance" v) in
      let relation = get_text "relation" relation in
      let goals = read_goals left right relation tolerance in
      let said = entries left @ entries right @ Option.to_list tolerance in
      let goals =
        if context.questions = [] then goals
        else
          let values = Answers.settle context (said @ List.rev context.said) answers point in
          context.given <- List.map values context.given;
          context.zeros <- List.map values context.zeros;
          context.said <- List.rev_map values (said @ List.rev context.said);
          List.map (fun (t, r) -> (values t, r)) goals
      in
      let said = if context.questions = [] then said @ List.rev context.said else List.rev context.said in
      let goals, said =
        match order with
        | None -> (goals, said)
        | Some value ->
            if relation <> "=" || tolerance <> None then refuse "order goes with = only";
            let order = read_order box context value in
            let goals, at_zero = expand_order context order goals in
            List.iter (say_smooth context) said;
            (goals, List.map at_zero (said @ List.rev context.said) @ List.map fst goals)
      in
      (context, { goals; box; said; given = context.given; zeros = context.zeros; fractions = context.fractions })
  | _ -> assert false

(* The cases of a statement. [answers] are those to its questions, at a point or in the whole box. *)
let read_statement ?point answers value =
  let o = get_object "statement" value in
  let given keys = List.filter (fun k -> List.mem_assoc k o) keys in
  let is_long = given more_keys <> [] and get name = List.assoc_opt name o in
  let keys = plain_keys @ if is_long then more_keys else [] in
  ignore (get_keys "statement" (keys @ given [ "order"; "random" ]) value);
  let values = List.map (fun k -> List.assoc k o) keys in
  let long_values = if is_long then [] else [ Object []; List []; Object [] ] in
  let random = match get "random" with Some v -> get_object "random" v | None -> [] in
  let answers = ref (get_list "answers" answers) in
  let rec go count plan =
    if count > 128 then refuse "more than 128 cases";
    let context, case = read_case values long_values (get "order") random plan ~answers ~point in
    case :: match next_plan context.answers with None -> [] | Some plan -> go (count + 1) plan
  in
  let cases = go 1 [] in
  if !answers <> [] then refuse "an answer without a question";
  cases

(* A tree of `given` that is a symbol, or -1 times a symbol, cuts the range at 0. *)
let goal_of s (tree, relation) =
  let fraction (name, _) = (name, { anything with low = Some zero; high = Some one; open_high = true }) in
  let goal = { tree; relation; box = List.map fraction s.fractions @ s.box; exists = s.said; given = s.given; zeros = s.zeros } in
  let cut goal = function
    | Sym name -> cut_range goal name 1
    | Prod [ Num q; Sym name ] when Q.equal q Q.minus_one -> cut_range goal name (-1)
    | _ -> goal
  in
  List.iter (fun t -> check_symbols (premise goal t relation)) (s.said @ s.given @ s.zeros);
  List.fold_left cut goal s.given

(* All that the statement says has a finite ball at a point in the box, and the hypotheses hold there. *)
let check_values (s : statement) point =
  check_point s.box point;
  let add_fraction point (name, u) =
    let value = put point u in
    (name, subtract value (number (find_whole value))) :: point
  in
  let point = List.fold_left add_fraction point s.fractions in
  let balls = List.map (fun (name, t) -> (name, number_ball name t)) point in
  let value name = match List.assoc_opt name balls with Some x -> x | None -> no_symbols name in
  List.iter (fun t -> if finite_ball value t = None then refuse "no value at the point") s.said;
  let is_positive t = match finite_ball value t with Some x -> sign_of x.lo >= 0 | None -> false in
  let is_null t = Algebra.vanishes (put point t) in
  shown "a hypothesis does not hold at the point"
    (List.for_all (fun t -> is_positive t || is_null t) s.given && List.for_all is_null s.zeros);
  (point, value)

(* The values at the point, and the cases to which it belongs; there is one at least. *)
let check_cases cases point =
  let belongs case = match check_values case point with point, value -> Ok (point, value, case) | exception Refused why -> Error why in
  match List.partition_map (fun c -> match belongs c with Ok x -> Either.Left x | Error why -> Either.Right why) cases with
  | [], why :: _ -> refuse "%s" why
  | found, _ -> found
